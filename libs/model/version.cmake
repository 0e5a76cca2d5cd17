# Writes OUTPUT with the project's version and the commit: "0.1.0+1a2b3c4d". It is that of the git checkout, or the one that
# `git archive` wrote into commit.txt.
execute_process(COMMAND git -C ${SOURCE} rev-parse --short=8 HEAD
                OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
execute_process(COMMAND git -C ${SOURCE} rev-parse --show-prefix
                OUTPUT_VARIABLE below OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET) # in another project's checkout
set(text "${VERSION}")
if(NOT failed AND NOT below)
  string(APPEND text "+${commit}")
  execute_process(COMMAND git -C ${SOURCE} status --porcelain -- apps libs CMakeLists.txt
                  OUTPUT_VARIABLE changes ERROR_QUIET)
  if(changes)
    string(APPEND text ".modified")
  endif()
endif()
file(STRINGS ${CMAKE_CURRENT_LIST_DIR}/commit.txt archived REGEX "^[0-9a-f]+$")
if(text STREQUAL VERSION AND archived)
  string(SUBSTRING ${archived} 0 8 commit)
  string(APPEND text "+${commit}")
endif()
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT "#define JOINTCREEP_VERSION \"${text}\"\n")
