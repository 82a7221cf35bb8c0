cmake_minimum_required(VERSION 3.21)
# Writes the commit that is built into FILE, and leaves the file alone where it says so already.
execute_process(COMMAND git describe --always --dirty --abbrev=10 WORKING_DIRECTORY ${SOURCE}
  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
if(failed OR NOT commit)
  set(commit "unknown")
endif()
file(CONFIGURE OUTPUT ${FILE} CONTENT "extern const char ck_commit[];\nconst char ck_commit[] = \"@commit@\";\n" @ONLY)
