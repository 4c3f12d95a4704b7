# CPack runs this before it packs what it installed. Sections that only name the compiler go. No file is newer than
# SOURCE_DATE_EPOCH, so that equal builds give equal packages.
execute_process(COMMAND find ${CPACK_TEMPORARY_DIRECTORY} -type f ( -name *.a -o -name *.so* -o -path */bin/* -o -name lorica_character_reader )
                        -exec ${CPACK_LORICA_STRIP} --enable-deterministic-archives --strip-debug --remove-section=.comment {} +
                COMMAND_ERROR_IS_FATAL ANY)
if(DEFINED ENV{SOURCE_DATE_EPOCH})
  execute_process(COMMAND find ${CPACK_TEMPORARY_DIRECTORY} -exec touch --no-dereference --date=@$ENV{SOURCE_DATE_EPOCH} {} +
                  COMMAND_ERROR_IS_FATAL ANY)
endif()
