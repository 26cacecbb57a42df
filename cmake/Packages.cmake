# Debian packages (./setup.sh package): perception, programs with all that they need; libperception-pipeline and -detectors, the
# libraries that others link; libperception-dev, their headers; python3-perception, the module of Python. What they depend on is read
# from the binaries, but for what headers and plots need.
set(SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set(PERCEPTION_CONTACT "perception@packages.invalid" CACHE STRING "Address of who packs it")
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "The perception authors <${PERCEPTION_CONTACT}>")
set(CPACK_PACKAGE_VENDOR "The perception authors")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL programs pipeline detectors development)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_LIBRARY_OUTPUT_DIRECTORY})
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(CPACK_DEBIAN_PROGRAMS_PACKAGE_NAME perception)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_SECTION science)
# A machine without these has no plots, no pictures without a display, no films.
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_RECOMMENDS "gnuplot-nox, libgl1-mesa-dri")
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_SUGGESTS "ffmpeg, mrpt-apps, python3-numpy")
set(CPACK_COMPONENT_PROGRAMS_DESCRIPTION "From a log of lidar, radar, camera and pose (an MRPT rawlog) it says at every
 instant which objects are around, where, how fast and what they are, also in
 rain, snow and fog. With importers, a simulator, evaluation, pictures and a
 demo: perception-demo.")

# Each with its own dependencies: images bring OpenCV's networks.
foreach(LIBRARY pipeline detectors)
  string(TOUPPER ${LIBRARY} COMPONENT)
  set(CPACK_DEBIAN_${COMPONENT}_PACKAGE_NAME libperception-${LIBRARY}${SOVERSION})
  set(CPACK_DEBIAN_${COMPONENT}_PACKAGE_SECTION libs)
  set(CPACK_DEBIAN_${COMPONENT}_PACKAGE_CONTROL_EXTRA ${CMAKE_SOURCE_DIR}/cmake/debian/triggers)
endforeach()
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_DETECTORS_PACKAGE_DEPENDS "libperception-pipeline${SOVERSION} (= ${PROJECT_VERSION})")
set(CPACK_COMPONENT_PIPELINE_DESCRIPTION "Shared library: observations of lidar, radar and camera in, tracked and
 classified objects out.")
set(CPACK_COMPONENT_DETECTORS_DESCRIPTION "Shared library: finds objects in images.")

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libperception-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libperception-pipeline${SOVERSION} (= ${PROJECT_VERSION}),\
 libperception-detectors${SOVERSION} (= ${PROJECT_VERSION}), libeigen3-dev,\
 libmrpt-obs-dev, libmrpt-bayes-dev, libmrpt-maps-dev, libtbb-dev, nlohmann-json3-dev")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS "perception")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "Headers for programs that link the library (find_package(perception)), with
 examples.")

set(PACKED PROGRAMS PIPELINE DETECTORS DEVELOPMENT)
if(TARGET perception_python)
  list(APPEND CPACK_COMPONENTS_ALL python)
  list(APPEND PACKED PYTHON)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-perception)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3-numpy,\
 python3 (>= ${Python_VERSION_MAJOR}.${Python_VERSION_MINOR}), python3 (<< ${Python_VERSION_MAJOR}.${AFTER_PYTHON}~)")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "perception, python3-pandas")
  set(CPACK_COMPONENT_PYTHON_DESCRIPTION "Module perception for Python 3: arrays of numpy in, tracked and classified
 objects out; logs and runs as tables.")
endif()

# Every package has its license and its changes.
find_program(GZIP gzip)
foreach(COMPONENT ${PACKED})
  string(TOLOWER ${COMPONENT} component)
  set(PACKAGE ${CPACK_DEBIAN_${COMPONENT}_PACKAGE_NAME})
  set(DOC ${CMAKE_INSTALL_DATADIR}/doc/${PACKAGE})
  configure_file(cmake/debian/changelog.in ${CMAKE_BINARY_DIR}/debian/${PACKAGE}/changelog @ONLY)
  if(GZIP)
    execute_process(COMMAND ${GZIP} -9nf ${CMAKE_BINARY_DIR}/debian/${PACKAGE}/changelog COMMAND_ERROR_IS_FATAL ANY)
    install(FILES ${CMAKE_BINARY_DIR}/debian/${PACKAGE}/changelog.gz DESTINATION ${DOC} COMPONENT ${component})
  endif()
  install(FILES cmake/debian/copyright DESTINATION ${DOC} COMPONENT ${component})
endforeach()
include(CPack)
