# cmake -D SOURCE=FILE -D COMPILE=COMPILER;FLAG... -P expect_failure.cmake

file(STRINGS ${SOURCE} sentence LIMIT_COUNT 1)
if(NOT sentence MATCHES "^// expect: (.+)$")
  message(FATAL_ERROR "The first line of ${SOURCE} must be '// expect: SENTENCE'")
endif()
set(sentence "${CMAKE_MATCH_1}")

execute_process(COMMAND ${COMPILE} ${SOURCE} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
if(status EQUAL 0)
  message(FATAL_ERROR "It compiled; expected: ${sentence}")
endif()
string(REGEX MATCH "error: [^\n]*" first_error "${output}")
string(FIND "${first_error}" "${sentence}" at)
if(at EQUAL -1)
  message(FATAL_ERROR "The first error is not the expected one: ${sentence}\n${output}")
endif()
