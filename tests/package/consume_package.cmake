# SPDX-License-Identifier: Apache-2.0
# Installs the build into a fresh prefix, builds examples/embed against it, and renders one frame with it and one with
# the program: they must be the same picture.
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
run(${WORK_DIR}/prefix/bin/gazetrace --version)

# The courtyard has texture, lamps and an alpha mask; both pictures are of half floats, so that a squared error of
# exactly 0 means the same bits.
run(${WORK_DIR}/build/embed ${SCENE} ${WORK_DIR}/embedded.exr 0.25 0.5)
run(${WORK_DIR}/prefix/bin/gazetrace render ${SCENE} --gaze-at 0.25,0.5 --screen paper --size 320x180
  --frames 1 -o ${WORK_DIR}/program/frame.exr)
run(${WORK_DIR}/prefix/bin/gazetrace compare ${WORK_DIR}/program/frame.exr ${WORK_DIR}/embedded.exr --metrics mse
  --fail-above mse=0)
