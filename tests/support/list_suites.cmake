# Writes for ctest what suites a GoogleTest program has: each is one test, since a process takes longer to start than most tests
# take to run. A suite counts as skipped where all of its tests were.
#
#   cmake -D PROGRAM=FILE -D NAME=NAME -D OUT=FILE.cmake -P list_suites.cmake
execute_process(COMMAND ${PROGRAM} --gtest_list_tests OUTPUT_VARIABLE listed COMMAND_ERROR_IS_FATAL ANY TIMEOUT 60)
string(REGEX MATCHALL "\n[^ \n][^ \n]*\\." suites "\n${listed}")
set(all_skipped "\\[  PASSED  \\] 0 tests\\.\n\\[  SKIPPED \\] [0-9]+ tests?, listed below:\n(\\[  SKIPPED \\] [^\n]*\n)*$")
if(NOT suites)
  message(FATAL_ERROR "${PROGRAM} has no tests")
endif()
set(tests "")
foreach(suite ${suites})
  string(REGEX REPLACE "\n(.*)\\." "\\1" suite ${suite})
  string(APPEND tests "add_test([[${NAME}.${suite}]] [[${PROGRAM}]] [[--gtest_filter=${suite}.*]])\n"
    "set_tests_properties([[${NAME}.${suite}]] PROPERTIES ENVIRONMENT OBLIQ_CACHE_DIR= SKIP_REGULAR_EXPRESSION [[${all_skipped}]])\n")
endforeach()
file(WRITE ${OUT} "${tests}")
