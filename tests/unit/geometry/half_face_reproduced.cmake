# The committed sample face is what its script makes, byte for byte.
#   cmake -DFACES=<client/examples/faces> -DOUT=<folder> -DPYTHON=<python3> -P half_face_reproduced.cmake
file(MAKE_DIRECTORY ${OUT})
execute_process(COMMAND ${PYTHON} ${FACES}/make_half_face.py --out ${OUT} RESULT_VARIABLE result)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "make_half_face.py failed: ${result}")
endif()
foreach(file half_face.obj half_face.landmarks.json)
  execute_process(COMMAND ${CMAKE_COMMAND} -E compare_files ${FACES}/${file} ${OUT}/${file} RESULT_VARIABLE differs)
  if(differs)
    message(FATAL_ERROR "${file} is not what make_half_face.py makes: run it and commit the result")
  endif()
endforeach()
