# cmake -D NODE=<node> -D NPM=<npm> -D FROM=<viewer/page/web> -D TO=<folder> -P BuildPage.cmake
# Builds the page of `lorica serve`: index.html, page.css, and compressed page.js and licences.txt. Where node, npm or the
# packages cannot be had the files are empty, and the build goes on.
cmake_minimum_required(VERSION 3.25)

set(files index.html page.css page.js licences.txt)
function(without_page why)
  message(STATUS "The page of lorica serve is left out: ${why}. scripts/setup --page brings what it needs.")
  foreach(file ${files})
    file(WRITE ${TO}/${file} "")
  endforeach()
endfunction()

if(NOT NODE OR NOT NPM)
  without_page("node and npm are not installed")
  return()
endif()
file(MAKE_DIRECTORY ${TO}/npm)
file(COPY ${FROM}/package.json DESTINATION ${TO}/npm)
execute_process(COMMAND ${NPM} install --ignore-scripts --no-package-lock --no-audit --no-fund --fetch-retries=1
                WORKING_DIRECTORY ${TO}/npm RESULT_VARIABLE failed OUTPUT_QUIET ERROR_QUIET TIMEOUT 300)
if(failed)
  without_page("npm could not bring its packages")
  return()
endif()
execute_process(COMMAND ${NODE} ${FROM}/build.mjs ${TO}/made ${TO}/npm RESULT_VARIABLE failed ERROR_VARIABLE why
                OUTPUT_QUIET TIMEOUT 300)
if(failed)
  without_page("${why}")
  return()
endif()
foreach(file index.html page.css)
  file(COPY_FILE ${TO}/made/${file} ${TO}/${file})
endforeach()
foreach(file page.js licences.txt)
  execute_process(COMMAND ${NODE} -e "const [from, to] = process.argv.slice(1), fs = require('fs')
    fs.writeFileSync(to, require('zlib').gzipSync(fs.readFileSync(from), { level: 9 }))" ${TO}/made/${file} ${TO}/${file}
    COMMAND_ERROR_IS_FATAL ANY)
endforeach()
