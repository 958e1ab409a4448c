# cmake -D PROGRAM= -D OUT= -P pages.cmake: the program writes its manual pages and completion into OUT.
file(REMOVE_RECURSE ${OUT})
file(MAKE_DIRECTORY ${OUT}/man1)

function(write file)
  execute_process(COMMAND ${PROGRAM} ${ARGN} OUTPUT_FILE ${OUT}/${file} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

write(man1/soapfilm.1 man)
# The program's page ends with a list of its commands' pages.
file(STRINGS ${OUT}/man1/soapfilm.1 others REGEX "^\\.BR soapfilm")
foreach(line IN LISTS others)
  string(REGEX REPLACE "^\\.BR soapfilm.*-([a-z]+) .*" "\\1" command "${line}")
  write(man1/soapfilm-${command}.1 man ${command})
endforeach()
foreach(shell bash zsh fish)
  write(completion.${shell} completion ${shell})
endforeach()
file(TOUCH ${OUT}/made)
