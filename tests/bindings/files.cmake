# cmake -D FILES=<folder> -D TRUTH=<program> -D LORICA=<command> -D RECORDINGS=<folder> -P files.cmake
# Makes the files that the tests of the bindings share.
file(REMOVE_RECURSE ${FILES})
file(MAKE_DIRECTORY ${FILES})
set(ENV{XDG_CACHE_HOME} ${FILES}/cache)
# A node that contains itself, and a triangle.
set(start "<COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\"><asset><up_axis>Y_UP</up_axis></asset>")
set(scene "<library_visual_scenes><visual_scene id=\"s\"><node id=\"r\">NODE</node></visual_scene></library_visual_scenes><scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>")
string(REPLACE NODE "<instance_node url=\"#a\"/>" text
  "${start}<library_nodes><node id=\"a\"><instance_node url=\"#a\"/></node></library_nodes>${scene}")
file(WRITE ${FILES}/cycle.dae "${text}")
string(REPLACE NODE "<instance_geometry url=\"#g\"/>" text
  "${start}<library_geometries><geometry id=\"g\"><mesh><source id=\"p\"><float_array id=\"f\" count=\"9\">0 0 0 1 0 0 0 1 0</float_array><technique_common><accessor source=\"#f\" count=\"3\" stride=\"3\"><param name=\"X\" type=\"float\"/><param name=\"Y\" type=\"float\"/><param name=\"Z\" type=\"float\"/></accessor></technique_common></source><vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices><triangles count=\"1\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><p>0 1 2</p></triangles></mesh></geometry></library_geometries>${scene}")
file(WRITE ${FILES}/triangle.dae "${text}")

file(WRITE ${FILES}/room.json "{\"format\": \"lorica scene 1\", \"props\": [{\"shape\": \"box\", \"at\": [0.4, 0.9, 0.0], \"size\": [0.2, 0.8, 2.0], \"fixed\": true}]}")

set(commands
  "${LORICA} decompose mannequin --parts 4 -o ${FILES}/body.lorica"
  "${LORICA} convert walk ${FILES}/walk.bvh"
  "${LORICA} contacts ${FILES}/walk.bvh --decomposition ${FILES}/body.lorica --scene ${FILES}/room.json --out ${FILES}/contacts.npz"
  "${LORICA} contacts ${FILES}/walk.bvh --decomposition ${FILES}/body.lorica --scene ${FILES}/room.json --out ${FILES}/contacts.csv"
  "${TRUTH} glb ${FILES}/hero.glb"
  "${TRUTH} faces ${FILES}/breathing.glb"
  "${TRUTH} bucket ${FILES}/bucket.glb"
  "${LORICA} decompose ${FILES}/bucket.glb --parts 3 --walls auto --thickness 0.02 -o ${FILES}/bucket.lorica"
  "${LORICA} info ${FILES}/hero.glb --write-map ${FILES}/hero_map.json"
  "${LORICA} decompose ${FILES}/breathing.glb --parts 2 --hull-vertices 64 -o ${FILES}/breathing.lorica"
  "${TRUTH} hulls ${FILES}/body.lorica ${RECORDINGS}/walk.csv 40 ${FILES}/walk_csv.hulls"
  "${TRUTH} hulls ${FILES}/body.lorica ${FILES}/walk.bvh 40 ${FILES}/walk_bvh.hulls"
  "${TRUTH} touches ${FILES}/body.lorica ${RECORDINGS}/walk.csv 40 ${FILES}/walk_csv.touches"
  "${TRUTH} depth ${RECORDINGS}/wave_depth.oni 20 ${FILES}/depth")
foreach(command ${commands})
  separate_arguments(arguments UNIX_COMMAND "${command}")
  execute_process(COMMAND ${arguments} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "failed with ${status}: ${command}\n${output}")
  endif()
endforeach()
