# Headers of others that many sources include, read once and kept. A folder says with
# LIPOFILL_HEADERS which set its targets, and those of the folders below, start from. A source still
# includes what it uses: the sanitizers' presets build without precompiled headers.

#   lipofill_precompiled(SET HEADERS <a> <b> DEPENDS targets with the headers and their definitions)
function(lipofill_precompiled set)
  cmake_parse_arguments(ARG "" "" "HEADERS;DEPENDS" ${ARGN})
  add_library(precompiled_${set} OBJECT ${PROJECT_SOURCE_DIR}/cmake/precompiled.cc)
  target_link_libraries(precompiled_${set} PRIVATE ${ARG_DEPENDS} lipofill_compile)
  target_precompile_headers(precompiled_${set} PRIVATE ${ARG_HEADERS})
endfunction()

function(lipofill_use_precompiled target)
  if(NOT LIPOFILL_HEADERS OR CMAKE_DISABLE_PRECOMPILE_HEADERS)
    return()
  endif()
  target_precompile_headers(${target} REUSE_FROM precompiled_${LIPOFILL_HEADERS})
  # The compiler cache finds the headers' state through it.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)
endfunction()

set(LIPOFILL_STANDARD_HEADERS
  <algorithm> <array> <chrono> <cmath> <cstdint> <cstring> <filesystem> <fstream> <functional> <limits> <map> <memory> <mutex>
  <optional> <random> <set> <sstream> <string> <string_view> <thread> <utility> <variant> <vector>)
set(LIPOFILL_MODEL_HEADERS ${LIPOFILL_STANDARD_HEADERS}
  <absl/status/statusor.h> <absl/strings/str_cat.h> <absl/strings/str_format.h> <absl/strings/str_join.h>
  <Eigen/Core> <Eigen/Geometry> <Eigen/LU> <Eigen/SparseCore>)
set(LIPOFILL_SERVICE_HEADERS ${LIPOFILL_MODEL_HEADERS}
  <nlohmann/json.hpp> <grpcpp/grpcpp.h>
  <lipofill/v1/patient_service.grpc.pb.h> <lipofill/v1/simulation_service.grpc.pb.h> <lipofill/v1/frame_service.grpc.pb.h>)
