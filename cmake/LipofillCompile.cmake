# Warnings, floating-point rules and the compiler cache, for all of our own targets.

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM)
  set(launcher ${PROJECT_SOURCE_DIR}/cmake/cached_compile ${PROJECT_SOURCE_DIR})
  set(CMAKE_CXX_COMPILER_LAUNCHER ${launcher})
  set(CMAKE_C_COMPILER_LAUNCHER ${launcher})
endif()

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()
# Checks of invariants stay armed in a release.
string(REPLACE "-DNDEBUG" "" CMAKE_CXX_FLAGS_RELEASE "${CMAKE_CXX_FLAGS_RELEASE}")

# The instructions that programs may use. Its vectors reach Eigen's types, so all targets share one
# setting.
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  set(LIPOFILL_ARCH_DEFAULT x86-64-v3)
endif()
set(LIPOFILL_ARCH "${LIPOFILL_ARCH_DEFAULT}" CACHE STRING "Value of -march=; x86-64-v3 has AVX2 and FMA (2013 and later)")
if(LIPOFILL_ARCH)
  add_compile_options(-march=${LIPOFILL_ARCH})
endif()

if(LIPOFILL_SANITIZE)
  add_compile_options(-fsanitize=${LIPOFILL_SANITIZE} -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${LIPOFILL_SANITIZE})
endif()

# Tables of addresses are written once, before the program begins. Debian's compilers make programs
# position independent by themselves. tests/integration/deploy/check_hardening.py looks.
add_link_options(-Wl,-z,relro -Wl,-z,now -Wl,-z,noexecstack)

# There are some 230 programs to link. GNU gold comes with ld, and links them in a third of its
# time.
find_program(GOLD_PROGRAM ld.gold)
if(GOLD_PROGRAM)
  add_link_options(-fuse-ld=gold)
endif()

# For the folders that programs are made of: the stack guards its returns, and calls know the size
# of what they write to. Sanitizers do more than that.
function(lipofill_harden)
  if(NOT LIPOFILL_SANITIZE)
    add_compile_options(-fstack-protector-strong $<$<CONFIG:Release,RelWithDebInfo>:-D_FORTIFY_SOURCE=2>)
  endif()
endfunction()

# Contraction to fused multiply-add would make results depend on how the compiler schedules an
# expression.
add_library(lipofill_compile INTERFACE)
target_compile_options(lipofill_compile INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -ffp-contract=off)
target_include_directories(lipofill_compile INTERFACE ${PROJECT_SOURCE_DIR})

# One static library a folder, from the sources named.
#   lipofill_library(NAME SOURCES a.cc b.cc DEPENDS other_targets)
function(lipofill_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_link_libraries(${name} PUBLIC ${ARG_DEPENDS} PRIVATE lipofill_compile)
  target_include_directories(${name} PUBLIC ${PROJECT_SOURCE_DIR})
  lipofill_use_precompiled(${name})
endfunction()

# One test program from the sources named, each of its cases a ctest with the label.
#   lipofill_test(NAME LABEL unit SOURCES a_test.cc DEPENDS targets [TIMEOUT seconds] [RANDOM RapidCheck's parameters])
function(lipofill_test name)
  cmake_parse_arguments(ARG "" "LABEL;TIMEOUT;RANDOM" "SOURCES;DEPENDS" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()
  if(ARG_RANDOM)
    set(environment ENVIRONMENT "RC_PARAMS=${ARG_RANDOM}")
  endif()
  foreach(source ${ARG_SOURCES})
    set_property(GLOBAL APPEND PROPERTY LIPOFILL_TEST_SOURCES ${CMAKE_CURRENT_SOURCE_DIR}/${source})
  endforeach()
  add_executable(${name} ${ARG_SOURCES})
  target_compile_definitions(${name} PRIVATE LIPOFILL_SHARED_DATA="${LIPOFILL_SHARED_DATA}")
  target_link_libraries(${name} PRIVATE ${ARG_DEPENDS} GTest::gtest GTest::gmock GTest::gtest_main lipofill_compile)
  lipofill_use_precompiled(${name})
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/tests)
  gtest_discover_tests(${name} TEST_PREFIX ${ARG_LABEL}. DISCOVERY_TIMEOUT 60
    PROPERTIES LABELS ${ARG_LABEL} TIMEOUT ${ARG_TIMEOUT} ${environment})
  lipofill_tests_of(${ARG_LABEL} ${name})
endfunction()

# The target tests_LABEL builds all programs of the tests with that label.
function(lipofill_tests_of label name)
  if(NOT TARGET tests_${label})
    add_custom_target(tests_${label})
  endif()
  add_dependencies(tests_${label} ${name})
endfunction()
