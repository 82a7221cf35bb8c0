# The walls. A folder is a static library, and its own folder is all that its users can include from: a header of a
# folder that is not named is not found, and CMake refuses a circle.
set_property(GLOBAL PROPERTY GLOBAL_DEPENDS_NO_CYCLES ON)

# A folder.
#   SOURCES         one a line
#   VECTOR_SOURCES  compiled once for each kind of vectors; they say CK_LOOP(name)
#   SINGLE_SOURCES, SINGLE_VECTOR_SOURCES  of both, those that are compiled again for single precision, with CK_SINGLE
#   USES            folders whose headers its own headers include
#   USES_INSIDE     folders that only its sources include, so that its users do not see them
#   DEFINITIONS     of its sources
#   LIBRARIES       others, for its sources
# Headers in inside/ are for the folder itself and for its tests.
function(clothcheck_layer name)
  cmake_parse_arguments(PARSE_ARGV 1 LAYER "" "" "SOURCES;VECTOR_SOURCES;SINGLE_SOURCES;SINGLE_VECTOR_SOURCES;USES;USES_INSIDE;DEFINITIONS;LIBRARIES")
  list(TRANSFORM LAYER_USES PREPEND ck_)
  list(TRANSFORM LAYER_USES_INSIDE PREPEND ck_)
  add_library(ck_${name} STATIC ${LAYER_SOURCES})
  target_include_directories(ck_${name} PUBLIC . PRIVATE inside)
  target_compile_definitions(ck_${name} PRIVATE ${LAYER_DEFINITIONS})
  target_link_libraries(ck_${name} PUBLIC options ${LAYER_USES} PRIVATE ${LAYER_USES_INSIDE} ${LAYER_LIBRARIES})
  if(LAYER_VECTOR_SOURCES)
    foreach(vectors IN LISTS CLOTHCHECK_VECTORS)
      target_compile_definitions(ck_${name} PRIVATE CK_HAS_${vectors})
    endforeach()
    clothcheck_vectors(${name} "" ${LAYER_VECTOR_SOURCES})
  endif()
  if(LAYER_SINGLE_SOURCES)
    clothcheck_vectors(${name} single_ ${LAYER_SINGLE_VECTOR_SOURCES})
    clothcheck_objects(ck_${name}_single CK_SINGLE ${LAYER_SINGLE_SOURCES})
    target_sources(ck_${name} PRIVATE $<TARGET_OBJECTS:ck_${name}_single>)
  endif()
endfunction()

# The kinds of vectors; the program chooses when it runs.
if(CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64")
  set(CLOTHCHECK_VECTORS plain v3 v4 CACHE STRING "kinds of vectors: plain, v3 with it, v4 with both")
  # whatever CFLAGS say, so that each kind is what it is called
  set(MACHINE_plain -march=x86-64 -mno-avx -mno-fma)
  set(MACHINE_v3 -march=x86-64-v3)
  set(MACHINE_v4 -march=x86-64-v4)
else()
  set(CLOTHCHECK_VECTORS plain)
endif()

# Sources of a layer as objects of their own, with a definition.
macro(clothcheck_objects objects definition)
  add_library(${objects} OBJECT ${ARGN})
  target_include_directories(${objects} PRIVATE . inside)
  target_link_libraries(${objects} PRIVATE options ${LAYER_USES} ${LAYER_USES_INSIDE})
  target_compile_definitions(${objects} PRIVATE ${LAYER_DEFINITIONS} ${definition})
endmacro()

# precision: nothing, or single_
macro(clothcheck_vectors name precision)
  foreach(vectors IN LISTS CLOTHCHECK_VECTORS)
    set(objects ck_${name}_${precision}${vectors})
    clothcheck_objects(${objects} CK_VECTORS=${precision}${vectors} ${ARGN})
    target_compile_definitions(${objects} PRIVATE
      CK_VECTORS_NAME="$<$<NOT:$<STREQUAL:${vectors},plain>>:x86-64->${vectors}"
      $<$<STREQUAL:${precision},single_>:CK_SINGLE>)
    # a root sets no error number
    target_compile_options(${objects} PRIVATE ${MACHINE_${vectors}} -fno-math-errno)
    set_target_properties(${objects} PROPERTIES VECTOR_LOOPS ON)
    if(NOT vectors STREQUAL "plain")
      set_target_properties(${objects} PROPERTIES WIDE_VECTORS ON)
    endif()
    target_sources(ck_${name} PRIVATE $<TARGET_OBJECTS:${objects}>)
  endforeach()
endmacro()

# A text below bridge/ as a C string, with what its lines "//: use NAME" name of bridge/code put in their place.
function(clothcheck_text name file symbol)
  set(folder ${CMAKE_SOURCE_DIR}/bridge/code)
  file(READ ${CMAKE_SOURCE_DIR}/bridge/${file} text)
  set(files ${CMAKE_SOURCE_DIR}/bridge/${file})
  while(text MATCHES "//: use ([a-z_]+)\n")
    file(READ ${folder}/${CMAKE_MATCH_1}.inc part)
    string(REPLACE "${CMAKE_MATCH_0}" "${part}" text "${text}")
    list(APPEND files ${folder}/${CMAKE_MATCH_1}.inc)
  endwhile()
  string(REPLACE "\\" "\\\\" text "${text}")
  string(REPLACE "\"" "\\\"" text "${text}")
  string(REPLACE "\n" "\\n\"\n\"" text "${text}")
  file(CONFIGURE OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/${symbol}.c CONTENT "extern const char ${symbol}[];\nconst char ${symbol}[] = \"@text@\";\n" @ONLY)
  target_sources(ck_${name} PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/${symbol}.c)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${files})
endfunction()

# An engine: its folder, its source, and the ck_Engine constants that the source defines, in the order of the reports.
function(clothcheck_engine name source)
  target_sources(ck_${name} PRIVATE ${source})
  set_property(GLOBAL APPEND PROPERTY CK_ENGINES ${ARGN})
endfunction()
