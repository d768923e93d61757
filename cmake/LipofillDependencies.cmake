# Debian 12 packages; deploy/setup installs them. core/doc/licences.md lists their licences.

find_package(Threads REQUIRED)
find_package(absl REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(Ceres REQUIRED)
find_path(OPENTURNS_INCLUDE_DIR openturns/OT.hxx REQUIRED)
find_library(OPENTURNS_LIBRARY OT REQUIRED)
add_library(lipofill_openturns INTERFACE)
target_include_directories(lipofill_openturns SYSTEM INTERFACE ${OPENTURNS_INCLUDE_DIR})
target_link_libraries(lipofill_openturns INTERFACE ${OPENTURNS_LIBRARY})
find_package(Protobuf CONFIG QUIET)
if(NOT Protobuf_FOUND)
  find_package(Protobuf REQUIRED)
endif()
find_package(gRPC CONFIG REQUIRED)
find_package(spdlog REQUIRED)
find_package(CLI11 REQUIRED)
find_package(nlohmann_json 3.11 REQUIRED)
find_package(prometheus-cpp REQUIRED)
find_package(SQLite3 REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(PQXX REQUIRED IMPORTED_TARGET libpqxx)
pkg_check_modules(PQ REQUIRED IMPORTED_TARGET libpq)
find_package(OpenSSL REQUIRED)
find_package(LibXml2 REQUIRED)
find_package(VTK 9.1 REQUIRED COMPONENTS
  CommonCore CommonDataModel CommonExecutionModel CommonTransforms FiltersCore FiltersGeneral FiltersGeometry
  FiltersModeling FiltersSources FiltersVerdict IOGeometry IOImage IOLegacy IOPLY IOXML ImagingCore ImagingGeneral
  InteractionStyle RenderingCore RenderingAnnotation RenderingFreeType RenderingOpenGL2)
# Debian's interpreter: its packages, gRPC among them, are not for others.
find_program(LIPOFILL_PYTHON NAMES python3 PATHS /usr/bin NO_DEFAULT_PATH)
if(NOT LIPOFILL_PYTHON)
  find_program(LIPOFILL_PYTHON NAMES python3 REQUIRED)
endif()
find_program(GRPC_PYTHON_PLUGIN grpc_python_plugin REQUIRED)
if(LIPOFILL_TESTS)
  find_package(GTest REQUIRED)
  find_package(rapidcheck REQUIRED)
  include(GoogleTest)
endif()
if(LIPOFILL_TESTS AND LIPOFILL_BENCHMARKS)
  find_package(benchmark REQUIRED)
endif()

# cpp-httplib's Debian package has no CMake file; its class layouts depend on these definitions.
find_library(HTTPLIB_LIBRARY cpp-httplib REQUIRED)
add_library(lipofill_httplib INTERFACE)
target_compile_definitions(lipofill_httplib INTERFACE
  CPPHTTPLIB_OPENSSL_SUPPORT CPPHTTPLIB_ZLIB_SUPPORT CPPHTTPLIB_BROTLI_SUPPORT)
target_link_libraries(lipofill_httplib INTERFACE ${HTTPLIB_LIBRARY} OpenSSL::SSL OpenSSL::Crypto Threads::Threads)

# CHOLMOD's Debian package has no CMake file. Its BLAS must be OpenBLAS with POSIX threads, told to
# use one thread (sessions run in parallel, see core/coupling/coupled_factor.cc): Debian's serial
# OpenBLAS is built without locks and, called from two threads at once, now and then gives wrong
# results.
find_path(CHOLMOD_INCLUDE_DIR cholmod.h PATH_SUFFIXES suitesparse REQUIRED)
find_library(CHOLMOD_LIBRARY cholmod REQUIRED)
find_library(OPENBLAS_LIBRARY openblas PATHS
  /usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/openblas-pthread /usr/lib/x86_64-linux-gnu/openblas-pthread
  /usr/lib/aarch64-linux-gnu/openblas-pthread NO_DEFAULT_PATH REQUIRED)
add_library(lipofill_cholmod INTERFACE)
target_include_directories(lipofill_cholmod SYSTEM INTERFACE ${CHOLMOD_INCLUDE_DIR})
target_link_libraries(lipofill_cholmod INTERFACE ${CHOLMOD_LIBRARY} ${OPENBLAS_LIBRARY} gomp)
# CHOLMOD asks for libblas and liblapack by name and would take the machine's default. Ours, needed
# by the program itself, are loaded first and stay in its place.
get_filename_component(OPENBLAS_DIR ${OPENBLAS_LIBRARY} DIRECTORY)
target_link_libraries(lipofill_cholmod INTERFACE
  ${OPENBLAS_DIR}/liblapack.so.3 ${OPENBLAS_DIR}/libblas.so.3)
target_link_options(lipofill_cholmod INTERFACE -Wl,--no-as-needed -Wl,-rpath,${OPENBLAS_DIR})
