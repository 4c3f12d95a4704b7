# cmake --install: the command, the libraries with their headers, the recordings, and what find_package(lorica) reads.

include(CMakePackageConfigHelpers)

set(lorica_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/lorica)

# lorica::lorica stands for all folders.
add_library(lorica_all INTERFACE)
add_library(lorica::lorica ALIAS lorica_all)
set_target_properties(lorica_all PROPERTIES EXPORT_NAME lorica)
get_property(every GLOBAL PROPERTY LORICA_COMPONENTS)
list(TRANSFORM every PREPEND lorica::)
target_link_libraries(lorica_all INTERFACE ${every})
install(TARGETS lorica_all EXPORT loricaTargets)

# find_package(lorica COMPONENTS acd) looks for what acd and the libraries that it links need, and for nothing else.
function(lorica_packages_of name out)
  set(packages)
  get_property(links GLOBAL PROPERTY LORICA_LINKS_${name})
  foreach(link ${links})
    if(link MATCHES "^lorica::(.*)")
      lorica_packages_of(${CMAKE_MATCH_1} inner)
      list(APPEND packages ${inner})
    elseif(link MATCHES "^PkgConfig::(.*)")
      list(APPEND packages ${CMAKE_MATCH_1})
    elseif(link MATCHES "^nlohmann_json::")
      # Only in sources: whoever links lorica does not need it.
    elseif(link MATCHES "^([^:]+)::")
      list(APPEND packages ${CMAKE_MATCH_1})
    elseif(link STREQUAL "glfw")
      list(APPEND packages glfw3)
    endif()
  endforeach()
  list(REMOVE_DUPLICATES packages)
  list(SORT packages)
  set(${out} ${packages} PARENT_SCOPE)
endfunction()

get_property(LORICA_COMPONENTS GLOBAL PROPERTY LORICA_COMPONENTS)
set(LORICA_COMPONENT_PACKAGES)
foreach(component ${LORICA_COMPONENTS})
  lorica_packages_of(${component} packages)
  string(APPEND LORICA_COMPONENT_PACKAGES "set(lorica_packages_${component} ${packages})\n")
endforeach()

# What scripts/site makes the reference of.
get_property(headers GLOBAL PROPERTY LORICA_HEADERS)
list(JOIN headers "\n" headers)
file(WRITE ${PROJECT_BINARY_DIR}/installed_headers.txt "${headers}\n")

install(EXPORT loricaTargets NAMESPACE lorica:: DESTINATION ${lorica_package_dir})
configure_package_config_file(tools/cmake/lorica-config.cmake.in ${PROJECT_BINARY_DIR}/lorica-config.cmake
                              INSTALL_DESTINATION ${lorica_package_dir} PATH_VARS CMAKE_INSTALL_DATADIR)
# Below 1.0 a minor version may change the interface.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/lorica-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/lorica-config.cmake ${PROJECT_BINARY_DIR}/lorica-config-version.cmake
        DESTINATION ${lorica_package_dir})

install(DIRECTORY recordings/ DESTINATION ${CMAKE_INSTALL_DATADIR}/lorica/recordings COMPONENT command)
install(DIRECTORY docs/samples/depth/ DESTINATION ${CMAKE_INSTALL_DATADIR}/lorica/senders COMPONENT command)
set(documents README.md)
if(NOT LORICA_PACKAGE_DOCS)  # Debian has its own names for these, and the licence once for all packages
  list(APPEND documents LICENSE CHANGELOG.md)
endif()
install(FILES ${documents} DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT command)
install(FILES tools/packaging/lorica.desktop DESTINATION ${CMAKE_INSTALL_DATADIR}/applications COMPONENT command)
install(FILES tools/packaging/lorica-mime.xml DESTINATION ${CMAKE_INSTALL_DATADIR}/mime/packages RENAME lorica.xml COMPONENT command)
install(FILES tools/packaging/lorica.svg DESTINATION ${CMAKE_INSTALL_DATADIR}/icons/hicolor/scalable/apps COMPONENT command)
install(FILES tools/packaging/org.lorica.Lorica.metainfo.xml DESTINATION ${CMAKE_INSTALL_DATADIR}/metainfo COMPONENT command)
install(FILES tools/packaging/completion.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
        RENAME lorica COMPONENT command)
