# What is installed: programs with INIs, models, manual pages and the plugin; the library that others link; its headers.
include(CMakePackageConfigHelpers)

set(DATA_DIR ${CMAKE_INSTALL_DATADIR}/perception)
set(HEADER_DIR ${CMAKE_INSTALL_INCLUDEDIR}/perception)

# perception_library(COMPONENT MODULES modules... [OF library] INTERFACE libs...): modules as one shared library,
# perception::COMPONENT for other projects. Its own programs link the modules, each what it needs.
function(perception_library COMPONENT)
  cmake_parse_arguments(ARG "" "OF" "MODULES;INTERFACE" ${ARGN})
  set(LIBRARY perception_${COMPONENT}_library)
  set(OBJECTS)
  foreach(MODULE ${ARG_MODULES})
    list(APPEND OBJECTS $<TARGET_OBJECTS:perception_${MODULE}>)
    install(DIRECTORY ${CMAKE_SOURCE_DIR}/libperception/${MODULE} DESTINATION ${HEADER_DIR}/libperception
            COMPONENT development FILES_MATCHING PATTERN "*.h")
  endforeach()
  add_library(${LIBRARY} SHARED ${OBJECTS})
  list(GET ARG_MODULES -1 LAST)
  # The library before the modules: what it has already is not taken from these.
  target_link_libraries(${LIBRARY} PUBLIC ${ARG_OF} PRIVATE perception_${LAST} INTERFACE ${ARG_INTERFACE})
  target_link_options(${LIBRARY} PRIVATE -Wl,--as-needed -Wl,--no-undefined)
  target_compile_features(${LIBRARY} INTERFACE cxx_std_17)
  target_include_directories(${LIBRARY} INTERFACE $<INSTALL_INTERFACE:${HEADER_DIR}>)
  set_target_properties(${LIBRARY} PROPERTIES OUTPUT_NAME perception_${COMPONENT} EXPORT_NAME ${COMPONENT} LINKER_LANGUAGE CXX
                        VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  install(TARGETS ${LIBRARY} EXPORT perception-${COMPONENT}
          LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT ${COMPONENT} NAMELINK_COMPONENT development)
  install(EXPORT perception-${COMPONENT} NAMESPACE perception:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/perception
          FILE perception-${COMPONENT}.cmake COMPONENT development)
endfunction()

perception_library(pipeline
  MODULES core config simd measurement filter lidar odometry radar boxes3d vision weather grid sensors scene pipeline
  INTERFACE Eigen3::Eigen mrpt::obs mrpt::bayes mrpt::maps TBB::tbb nlohmann_json::nlohmann_json)
perception_library(detectors MODULES detectors OF perception_pipeline_library)

configure_package_config_file(cmake/perception-config.cmake.in ${CMAKE_BINARY_DIR}/perception-config.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/perception)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/perception-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/perception-config.cmake ${CMAKE_BINARY_DIR}/perception-config-version.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/perception COMPONENT development)
install(DIRECTORY examples DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT development)

get_property(PROGRAMS GLOBAL PROPERTY PERCEPTION_PROGRAMS)
install(TARGETS ${PROGRAMS} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT programs)
install(PROGRAMS apps/perception-demo/perception-demo DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT programs)
install(TARGETS perception_mrpt_plugin LIBRARY DESTINATION ${PLUGIN_DIR} COMPONENT programs)
if(TARGET perception_image_codecs)
  install(TARGETS perception_image_codecs LIBRARY DESTINATION ${PLUGIN_DIR} COMPONENT programs)
endif()
install(DIRECTORY ini DESTINATION ${DATA_DIR} COMPONENT programs)
install(FILES rawlogs/demo.rawlog rawlogs/demo.truth.csv rawlogs/README.md DESTINATION ${DATA_DIR}/rawlogs COMPONENT programs)
install(FILES apps/perception-export/perception_run.py DESTINATION ${DATA_DIR}/python COMPONENT programs)
list(APPEND PROGRAMS perception-demo)
foreach(PROGRAM ${PROGRAMS})
  install(FILES cmake/completion.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME ${PROGRAM}
          COMPONENT programs)
endforeach()

# Manual pages are what the programs say of themselves.
if(PERCEPTION_MANUALS)
  find_program(HELP2MAN help2man REQUIRED)
  set(PAGES)
  foreach(PROGRAM ${PROGRAMS})
    set(PAGE ${CMAKE_BINARY_DIR}/man/${PROGRAM}.1)
    set(FILE $<TARGET_FILE:${PROGRAM}>)
    set(NEEDS ${PROGRAM})
    if(NOT TARGET ${PROGRAM})
      set(FILE ${CMAKE_SOURCE_DIR}/apps/${PROGRAM}/${PROGRAM})
      set(NEEDS ${FILE})
    endif()
    add_custom_command(OUTPUT ${PAGE}.gz DEPENDS ${NEEDS} COMMAND ${CMAKE_COMMAND} -E make_directory ${CMAKE_BINARY_DIR}/man
      COMMAND ${CMAKE_COMMAND} -DHELP2MAN=${HELP2MAN} -DPROGRAM=${FILE} -DPAGE=${PAGE}
              -P ${CMAKE_SOURCE_DIR}/cmake/ManualPage.cmake
      COMMAND gzip -9nf ${PAGE} VERBATIM)
    list(APPEND PAGES ${PAGE}.gz)
  endforeach()
  add_custom_target(perception_manuals ALL DEPENDS ${PAGES})
  install(FILES ${PAGES} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT programs)
endif()
