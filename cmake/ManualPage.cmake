# cmake -DHELP2MAN=... -DPROGRAM=FILE -DPAGE=FILE.1 -P ManualPage.cmake: what --help begins with becomes the NAME section.
execute_process(COMMAND ${PROGRAM} --help OUTPUT_VARIABLE HELP COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCH "^[^:;\n]+" PURPOSE "${HELP}")
string(REGEX REPLACE "[. ]+$" "" PURPOSE "${PURPOSE}")
# help2man hands the program's path to a shell: it is run in its folder, whose path may have spaces.
get_filename_component(FOLDER ${PROGRAM} DIRECTORY)
get_filename_component(NAME ${PROGRAM} NAME)
execute_process(COMMAND ${HELP2MAN} --no-info "--name=${PURPOSE}" "--output=${PAGE}" ./${NAME} WORKING_DIRECTORY ${FOLDER}
                COMMAND_ERROR_IS_FATAL ANY)
