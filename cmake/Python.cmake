# The module perception of Debian's own Python: build/python/perception, with PYTHONPATH=build/python.
find_program(PERCEPTION_PYTHON python3 PATHS /usr/bin NO_DEFAULT_PATH)
set(PYBIND11_FINDPYTHON ON)
if(NOT SKBUILD)  # pip (pyproject.toml) builds for the Python that runs it
  set(Python_EXECUTABLE ${PERCEPTION_PYTHON})
endif()
find_package(Python QUIET COMPONENTS Interpreter Development.Module)
if(Python_FOUND)
  find_package(pybind11 QUIET)
endif()
if(NOT pybind11_FOUND OR PERCEPTION_SANITIZE MATCHES "thread|fuzzer")
  message(STATUS "No Python module: it needs pybind11-dev and python3-dev, and is not built for ThreadSanitizer or a fuzzer")
  return()
endif()

file(GLOB_RECURSE SOURCES CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/libperception/python/*.cpp)
pybind11_add_module(perception_python MODULE NO_EXTRAS ${SOURCES})
target_link_libraries(perception_python PRIVATE perception::app_track perception::app_evaluate perception::app_simulate)
target_compile_definitions(perception_python PRIVATE PERCEPTION_VERSION="${PROJECT_VERSION}")
target_compile_options(perception_python PRIVATE $<$<CONFIG:Release>:-O2>)
set_source_files_properties(${CMAKE_SOURCE_DIR}/libperception/python/arrays/Arrays.cpp PROPERTIES COMPILE_OPTIONS -O3)  # copies of scans
# Names of the libraries stay within the module: another module of the process may hold the same.
target_link_options(perception_python PRIVATE LINKER:--exclude-libs,ALL)
target_link_libraries(perception_python PRIVATE Python::Module)
set(PYTHON_FOLDER ${CMAKE_BINARY_DIR}/python/perception)
set_target_properties(perception_python PROPERTIES OUTPUT_NAME _core LIBRARY_OUTPUT_DIRECTORY ${PYTHON_FOLDER})
perception_batches(perception_python)

file(GLOB PARTS CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/libperception/python/perception/*)
list(APPEND PARTS ${CMAKE_SOURCE_DIR}/apps/perception-export/perception_run.py)
add_custom_command(OUTPUT ${PYTHON_FOLDER}/copied COMMAND ${CMAKE_COMMAND} -E copy ${PARTS} ${PYTHON_FOLDER}
  COMMAND ${CMAKE_COMMAND} -E touch ${PYTHON_FOLDER}/copied DEPENDS ${PARTS} VERBATIM)
add_custom_target(perception_python_parts ALL DEPENDS ${PYTHON_FOLDER}/copied)
add_dependencies(perception_python perception_python_parts)

math(EXPR AFTER_PYTHON "${Python_VERSION_MINOR} + 1")  # a module of one version is of no use to the next
if(SKBUILD)
  set(PYTHON_DIR perception)  # in the wheel
else()
  set(PYTHON_DIR lib/python3/dist-packages/perception)
endif()
install(TARGETS perception_python LIBRARY DESTINATION ${PYTHON_DIR} COMPONENT python)
install(FILES ${PARTS} DESTINATION ${PYTHON_DIR} COMPONENT python)
install(DIRECTORY ini DESTINATION ${PYTHON_DIR} COMPONENT python)  # the module needs no other package of ours
