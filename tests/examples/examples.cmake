# cmake -DBUILD=DIR -DSOURCE=DIR -DPYTHON=FILE -DGENERATOR=NAME -P examples.cmake: installs the build tree into BUILD/prefix, builds
# the examples against that and runs them: what other projects do. A CMake script, since the library of the tests must not help.
cmake_minimum_required(VERSION 3.22)
set(PREFIX ${BUILD}/prefix)
set(EXAMPLES ${BUILD}/examples)

# run(NAME WANTED COMMAND...): the command must succeed and print WANTED, a regular expression
function(run NAME WANTED)
  execute_process(COMMAND ${ARGN} WORKING_DIRECTORY ${BUILD} RESULT_VARIABLE CODE OUTPUT_VARIABLE OUT ERROR_VARIABLE OUT)
  if(NOT CODE EQUAL 0)
    message(FATAL_ERROR "${NAME}: ended with ${CODE}\n${OUT}")
  endif()
  if(NOT OUT MATCHES "${WANTED}")
    string(SUBSTRING "${OUT}" 0 2000 OUT)
    message(FATAL_ERROR "${NAME}: found\n${OUT}\nexpected ${WANTED}")
  endif()
  message(STATUS "${NAME}: ${CMAKE_MATCH_0}")
endfunction()

file(REMOVE_RECURSE ${PREFIX} ${EXAMPLES}-run)
run(install "Install configuration" ${CMAKE_COMMAND} --install ${BUILD} --prefix ${PREFIX})
run(configure "Generating done" ${CMAKE_COMMAND} -G ${GENERATOR} -S ${SOURCE}/examples -B ${EXAMPLES} -DCMAKE_BUILD_TYPE=Release
    -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER} -DCMAKE_PREFIX_PATH=${PREFIX})
run(build "Linking CXX executable|Built target|no work to do" ${CMAKE_COMMAND} --build ${EXAMPLES} -j 2)

# The library needs nothing that draws, simulates, parses command lines or runs networks.
file(GLOB_RECURSE LIBRARY ${PREFIX}/*/libperception_pipeline.so)
if(NOT LIBRARY)
  message(FATAL_ERROR "no libperception_pipeline.so below ${PREFIX}")
endif()
foreach(BINARY ${LIBRARY} ${EXAMPLES}/track_log)
  execute_process(COMMAND readelf -d ${BINARY} OUTPUT_VARIABLE DYNAMIC COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX MATCHALL "NEEDED[^\n]*(libGL|libOpenGL|glut|libEGL|embree|CLI11|opencv_dnn)[^\n]*" UNWANTED "${DYNAMIC}")
  if(UNWANTED)
    message(FATAL_ERROR "${BINARY} needs ${UNWANTED}")
  endif()
endforeach()

# INIs that are installed are found by name.
set(LOG ${PREFIX}/share/perception/rawlogs/demo.rawlog)
run(track_log "[1-9][0-9]* car at [^\n]*" ${EXAMPLES}/track_log demo.ini ${LOG})
run(own_front_end "s: [1-9][0-9]* objects" ${EXAMPLES}/own_front_end ${SOURCE}/examples/own_front_end/slice.ini ${LOG})
run(find_people "[0-9]+ boxes" ${EXAMPLES}/find_people detectors/people_hog.ini ${SOURCE}/docs/kitti.png)
run(perception-track ": [1-9][0-9]* scenes, [^\n]*" ${PREFIX}/bin/perception-track -c demo.ini -i ${LOG} -o ${EXAMPLES}-run)
set(ENV{PYTHONPATH} ${PREFIX}/share/perception/python)
set(ENV{PYTHONDONTWRITEBYTECODE} 1)
run(read_run "111 scenes, [0-9]+ objects, classes pedestrian" ${PYTHON} ${SOURCE}/examples/read_run/read_run.py ${EXAMPLES}-run)
run(plugin "libperception_mrpt_plugin.so" ${PREFIX}/bin/perception-grabber --plugin)
