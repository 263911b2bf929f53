# Run by every build; writes OUT only when the version changes, so a commit compiles one file again.
#
#   cmake -D SOURCE=FOLDER -D RELEASE=0.1.0 [-D COMMIT=HASH] -D OUT=FILE -P write_version.cmake
#
# The commit: COMMIT where it is given (an image's build has no history); what git says of SOURCE; in an archive that git made
# what export-subst (.gitattributes) wrote into archived_commit.txt.
if(NOT COMMIT AND EXISTS ${SOURCE}/.git)
  execute_process(COMMAND git -C ${SOURCE} --no-optional-locks describe --always --abbrev=7 --exclude=* --dirty
    OUTPUT_VARIABLE COMMIT OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
if(NOT COMMIT)
  file(STRINGS ${CMAKE_CURRENT_LIST_DIR}/archived_commit.txt COMMIT LIMIT_COUNT 1)
endif()
set(VERSION ${RELEASE})
if(COMMIT MATCHES "^([0-9a-f]+)(-dirty)?$")
  set(hash ${CMAKE_MATCH_1})
  set(dirty ${CMAKE_MATCH_2})
  string(LENGTH ${hash} length)
  if(length EQUAL 40)
    string(SUBSTRING ${hash} 0 7 hash)
  endif()
  set(VERSION ${RELEASE}+g${hash}${dirty})
endif()
configure_file(${CMAKE_CURRENT_LIST_DIR}/version.cpp.in ${OUT} @ONLY)
