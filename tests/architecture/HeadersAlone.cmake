# Every header compiles alone: the source beside it includes it first (architecture_tests holds that rule), and a header
# without a source gets a generated one here, built with all the others. Only changed ones compile again.
file(GLOB_RECURSE HEADERS CONFIGURE_DEPENDS RELATIVE ${CMAKE_SOURCE_DIR}
     ${CMAKE_SOURCE_DIR}/libperception/*.h ${CMAKE_SOURCE_DIR}/gui-offscreen/*.h ${CMAKE_SOURCE_DIR}/studies/*.h)
set(HEADER_SOURCES)
foreach(HEADER ${HEADERS})
  string(REGEX REPLACE "[.]h$" ".cpp" OWN_SOURCE ${HEADER})
  if(EXISTS ${CMAKE_SOURCE_DIR}/${OWN_SOURCE})
    continue()
  endif()
  set(SOURCE ${CMAKE_CURRENT_BINARY_DIR}/headers_alone/${HEADER}.cpp)
  file(GENERATE OUTPUT ${SOURCE} CONTENT "#include \"${HEADER}\"\n#include \"${HEADER}\"  // and twice\n")
  list(APPEND HEADER_SOURCES ${SOURCE})
endforeach()
add_library(headers_alone OBJECT ${HEADER_SOURCES})
target_link_libraries(headers_alone PRIVATE perception::studies perception::importers perception::capture perception::gui-offscreen)
target_compile_options(headers_alone PRIVATE -O0 -g0)
