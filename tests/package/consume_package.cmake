# SPDX-License-Identifier: Apache-2.0
# Installs the build into a fresh prefix, builds examples/embed against it and renders one frame, which has the same bits
# as the program's.
file(REMOVE_RECURSE ${WORK_DIR})
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE out ERROR_VARIABLE err)
  if(NOT code EQUAL 0)
    string(JOIN " " line ${ARGN})
    message(FATAL_ERROR "exit ${code}: ${line}\n${out}\n${err}")
  endif()
endfunction()
run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${WORK_DIR}/prefix)
run(${CMAKE_COMMAND} -S ${EXAMPLE_DIR} -B ${WORK_DIR}/build -G ${GENERATOR} -DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix
  -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_BUILD_TYPE=Release)
run(${CMAKE_COMMAND} --build ${WORK_DIR}/build)
run(${WORK_DIR}/build/embed ${SCENE} ${WORK_DIR}/frame.exr 0.25 0.5)
if(NOT EXISTS ${WORK_DIR}/frame.exr)
  message(FATAL_ERROR "embed wrote no frame")
endif()
run(${WORK_DIR}/prefix/bin/gazetrace --version)
run(${WORK_DIR}/prefix/bin/gazetrace render ${SCENE} -o ${WORK_DIR}/program/frame.exr --gaze-at 0.25,0.5 --screen paper
  --size 320x180)
run(${CMAKE_COMMAND} -E compare_files ${WORK_DIR}/frame.exr ${WORK_DIR}/program/frame.exr)
