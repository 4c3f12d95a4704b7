# What scripts/package makes of the installed files: `lorica`, the command with all that it needs at run time,
# `liblorica-c0`, the C interface, `python3-lorica`, the Python module, `liblorica-dev`, the static libraries, all headers
# and what find_package(lorica) reads, and `lorica-doc`, the site.

set(LORICA_PACKAGE_DEPENDS "" CACHE STRING "Packages that the command's needs, as dpkg-shlibdeps says")
set(LORICA_PACKAGE_C_DEPENDS "" CACHE STRING "The same for the C interface")
set(LORICA_PACKAGE_PYTHON_DEPENDS "" CACHE STRING "The same for the Python module")
set(LORICA_PACKAGE_RECOMMENDS "" CACHE STRING "Packages that only the writing of videos needs")
set(LORICA_PACKAGE_DOCS "" CACHE PATH "Folder of manual pages, changelog and copyright that scripts/package makes")
mark_as_advanced(LORICA_PACKAGE_DEPENDS LORICA_PACKAGE_C_DEPENDS LORICA_PACKAGE_PYTHON_DEPENDS LORICA_PACKAGE_RECOMMENDS
                 LORICA_PACKAGE_DOCS)
if(NOT LORICA_PACKAGE_DOCS)
  return()
endif()

foreach(package lorica:command liblorica-dev:development liblorica-c0:c python3-lorica:python lorica-doc:documentation)
  string(REPLACE ":" ";" package ${package})
  list(POP_FRONT package name)
  install(FILES ${LORICA_PACKAGE_DOCS}/copyright ${LORICA_PACKAGE_DOCS}/changelog.Debian.gz ${LORICA_PACKAGE_DOCS}/changelog.gz
          DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${name} COMPONENT ${package})
endforeach()
install(DIRECTORY ${LORICA_PACKAGE_DOCS}/html DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/lorica-doc COMPONENT documentation)
install(FILES tools/packaging/lorica-doc DESTINATION ${CMAKE_INSTALL_DATADIR}/doc-base COMPONENT documentation)
install(DIRECTORY ${LORICA_PACKAGE_DOCS}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT command)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "live motion-capture avatar that collides")
set(CPACK_PACKAGE_CONTACT "Lorica maintainers <maintainers@lorica.invalid>")
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_LORICA_STRIP ${CMAKE_STRIP})
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/tools/packaging/before_packing.cmake)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL command development c python)
if(NOT CMAKE_CROSSCOMPILING)  # the site is the same for every machine
  list(APPEND CPACK_COMPONENTS_ALL documentation)
endif()
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(version ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE})

set(CPACK_DEBIAN_COMMAND_PACKAGE_NAME lorica)
set(CPACK_DEBIAN_COMMAND_PACKAGE_SECTION graphics)
set(CPACK_COMPONENT_COMMAND_DESCRIPTION "Lorica reads a person's skeleton from a depth camera, a recording or a motion
file, poses a skinned character with it, and gives the character a body that
physics can touch: a small set of convex hulls that follow every frame.
.
This package has the command, sample recordings and a virtual depth camera.")
# Pictures without a display, depth cameras and letters are loaded by name, so that no file says it needs them.
set(CPACK_DEBIAN_COMMAND_PACKAGE_DEPENDS "${LORICA_PACKAGE_DEPENDS}, libosmesa6 | libegl1, libopenni2-0, fonts-dejavu-core")
set(CPACK_DEBIAN_COMMAND_PACKAGE_RECOMMENDS "${LORICA_PACKAGE_RECOMMENDS}, fonts-noto-cjk, libopenxr-loader1")

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME liblorica-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "Static libraries and headers of Lorica: convex decomposition of animated
meshes, live convex hulls, character import, retargeting and body tracking.")
# What lorica-config.cmake looks for; the modules that the libraries load come with the command.
string(CONCAT CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
  "lorica (= ${version}), liblorica-c0 (= ${version}), libeigen3-dev, libfmt-dev, "
  "libtbb-dev, libbullet-dev, libxxhash-dev, libhwy-dev, libglfw3-dev, libimgui-dev, libassimp-dev, libtinygltf-dev, "
  "libdraco-dev, libmeshoptimizer-dev, libpng-dev, libpugixml-dev, libqrcodegencpp-dev, libssl-dev, libturbojpeg0-dev, libwebp-dev, libzip-dev, zlib1g-dev, pkgconf | pkg-config")

# Both load a module of the command's package for meshes and characters that are open.
set(CPACK_DEBIAN_C_PACKAGE_NAME liblorica-c0)
set(CPACK_DEBIAN_C_PACKAGE_SECTION libs)
set(CPACK_COMPONENT_C_DESCRIPTION "Lorica for programs in C and languages that call C: convex decomposition of
meshes, live convex hulls of moving characters, body tracking.")
set(CPACK_DEBIAN_C_PACKAGE_DEPENDS "lorica (= ${version}), ${LORICA_PACKAGE_C_DEPENDS}")
# Says to packages that link it what they depend on, and that the loader's list of libraries changes.
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/liblorica-c0/shlibs
     CONTENT "liblorica_c 0 liblorica-c0 (>= ${PROJECT_VERSION})\n")
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/liblorica-c0/triggers CONTENT "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_C_PACKAGE_CONTROL_EXTRA
  ${PROJECT_BINARY_DIR}/liblorica-c0/shlibs ${PROJECT_BINARY_DIR}/liblorica-c0/triggers)

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-lorica)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_COMPONENT_PYTHON_DESCRIPTION "Lorica for Python: convex decomposition of meshes, live convex hulls of moving
characters, as numpy arrays.")
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/tools/packaging/python3-lorica/prerm)
# The module is made for one version of Python.
find_package(Python REQUIRED COMPONENTS Interpreter)
math(EXPR next_python "${Python_VERSION_MINOR} + 1")
string(CONCAT CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
  "lorica (= ${version}), python3 (>= 3.${Python_VERSION_MINOR}), python3 (<< 3.${next_python}), python3-numpy, "
  "${LORICA_PACKAGE_PYTHON_DEPENDS}")

set(CPACK_DEBIAN_DOCUMENTATION_PACKAGE_NAME lorica-doc)
set(CPACK_DEBIAN_DOCUMENTATION_PACKAGE_SECTION doc)
set(CPACK_DEBIAN_DOCUMENTATION_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_DOCUMENTATION_PACKAGE_SHLIBDEPS OFF)
set(CPACK_COMPONENT_DOCUMENTATION_DESCRIPTION "Documents of Lorica and the reference of its C++, C and Python
interfaces, as pages with a search that need no network. Open them at
/usr/share/doc/lorica-doc/html/index.html.")

include(CPack)
