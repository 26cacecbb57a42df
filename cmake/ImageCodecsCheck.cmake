# cmake -DNM=... -DOURS=FILE -DTHEIRS=FILE "-DUSERS=FILE;..." -P ImageCodecsCheck.cmake: all functions of OpenCV's imgcodecs that the
# libraries USERS need are in ours. A program would not start without.
cmake_minimum_required(VERSION 3.22)

# names(RESULT KIND FILE): of a library's dynamic symbols, --defined-only or --undefined-only
function(names RESULT KIND FILE)
  execute_process(COMMAND ${NM} -D -P ${KIND} ${FILE} OUTPUT_VARIABLE SYMBOLS COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX MATCHALL "_ZN[A-Za-z0-9_]+ [TU]" SYMBOLS "${SYMBOLS}")
  list(TRANSFORM SYMBOLS REPLACE " .*" "")
  set(${RESULT} ${SYMBOLS} PARENT_SCOPE)
endfunction()

names(HERE --defined-only ${OURS})
names(THERE --defined-only ${THEIRS})
foreach(USER ${USERS})
  names(NEEDED --undefined-only ${USER})
  foreach(NAME ${NEEDED})
    if(NAME IN_LIST THERE AND NOT NAME IN_LIST HERE)
      message(FATAL_ERROR "${USER} needs ${NAME}, which libperception/pictures/LateImageCodecs.cpp lacks: "
                          "cmake -DPERCEPTION_LATE_IMAGE_CODECS=OFF does without")
    endif()
  endforeach()
endforeach()
