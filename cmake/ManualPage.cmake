# cmake -DHELP2MAN=... -DPROGRAM=FILE -DPAGE=FILE.1 -P ManualPage.cmake: what --help begins with becomes the NAME section.
execute_process(COMMAND ${PROGRAM} --help OUTPUT_VARIABLE HELP COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCH "^[^:;\n]+" PURPOSE "${HELP}")
string(REGEX REPLACE "[. ]+$" "" PURPOSE "${PURPOSE}")
execute_process(COMMAND ${HELP2MAN} --no-info "--name=${PURPOSE}" --output=${PAGE} ${PROGRAM} COMMAND_ERROR_IS_FATAL ANY)
