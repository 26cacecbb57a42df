# Every header compiles alone: one generated source a header, built with all the others. Only changed ones compile again.
file(GLOB_RECURSE HEADERS CONFIGURE_DEPENDS RELATIVE ${CMAKE_SOURCE_DIR}
     ${CMAKE_SOURCE_DIR}/libperception/*.h ${CMAKE_SOURCE_DIR}/gui-offscreen/*.h)
set(HEADER_SOURCES)
foreach(HEADER ${HEADERS})
  set(SOURCE ${CMAKE_CURRENT_BINARY_DIR}/headers_alone/${HEADER}.cpp)
  file(GENERATE OUTPUT ${SOURCE} CONTENT "#include \"${HEADER}\"\n#include \"${HEADER}\"  // and twice\n")
  list(APPEND HEADER_SOURCES ${SOURCE})
endforeach()
add_library(headers_alone OBJECT ${HEADER_SOURCES})
target_link_libraries(headers_alone PRIVATE perception::app perception::capture)
target_compile_options(headers_alone PRIVATE -O0 -g0)
