# Debian 12 packages; deploy/setup installs them. README.md lists their licences.

find_package(Threads REQUIRED)
find_package(absl REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(Protobuf CONFIG QUIET)
if(NOT Protobuf_FOUND)
  find_package(Protobuf REQUIRED)
endif()
find_package(gRPC CONFIG REQUIRED)
find_package(spdlog REQUIRED)
find_package(CLI11 REQUIRED)
find_package(nlohmann_json 3.11 REQUIRED)
find_package(SQLite3 REQUIRED)
find_package(OpenSSL REQUIRED)
find_package(VTK 9.1 REQUIRED COMPONENTS
  CommonCore CommonDataModel CommonExecutionModel CommonTransforms FiltersCore FiltersGeneral FiltersGeometry
  FiltersModeling FiltersSources FiltersVerdict IOGeometry IOImage IOLegacy IOPLY IOXML ImagingCore ImagingGeneral
  InteractionStyle RenderingCore RenderingAnnotation RenderingFreeType RenderingOpenGL2)
if(LIPOFILL_TESTS)
  find_package(GTest REQUIRED)
  include(GoogleTest)
endif()

# CHOLMOD's Debian package has no CMake file. Its BLAS must be the serial OpenBLAS: sessions run in parallel, and threads of
# BLAS inside threads of ours only get in each other's way.
find_path(CHOLMOD_INCLUDE_DIR cholmod.h PATH_SUFFIXES suitesparse REQUIRED)
find_library(CHOLMOD_LIBRARY cholmod REQUIRED)
find_library(OPENBLAS_SERIAL_LIBRARY openblas PATHS
  /usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/openblas-serial /usr/lib/x86_64-linux-gnu/openblas-serial
  /usr/lib/aarch64-linux-gnu/openblas-serial NO_DEFAULT_PATH REQUIRED)
add_library(lipofill_cholmod INTERFACE)
target_include_directories(lipofill_cholmod SYSTEM INTERFACE ${CHOLMOD_INCLUDE_DIR})
target_link_libraries(lipofill_cholmod INTERFACE ${CHOLMOD_LIBRARY} ${OPENBLAS_SERIAL_LIBRARY} gomp)
