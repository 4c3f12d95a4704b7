# cmake -D BUILD=<build folder> -D SOURCE=<repository> -D PYTHON=<program> -D WORK=<folder> -P wheel.cmake
# Makes the wheel of what is built, installs it into a fresh virtual environment and uses it from there.
file(REMOVE_RECURSE ${WORK})
file(MAKE_DIRECTORY ${WORK})
set(ENV{PYTHONPATH})
set(ENV{PIP_DISABLE_PIP_VERSION_CHECK} 1)
set(ENV{PIP_NO_INDEX} 1)
file(WRITE ${WORK}/use.py "
import lorica, sys
assert lorica.__file__.startswith('${WORK}'), lorica.__file__
vertices = [[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)]
faces = [[4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4], [2, 6, 7], [2, 7, 3], [0, 4, 6], [0, 6, 2], [1, 3, 7], [1, 7, 5]]
parts = lorica.decompose(vertices, faces, parts=2)  # a box without a floor: the module that closes it is loaded
assert 'is open' in parts.repaired, parts.repaired
open('broken.dae', 'w').write('<COLLADA>')  # the program that reads such files is started
try:
    lorica.Character('broken.dae')
    sys.exit('broken.dae was read')
except ValueError as refused:
    assert 'broken COLLADA' in str(refused), refused
print(lorica.__version__, len(parts))
")
function(run)
  execute_process(COMMAND ${ARGN} WORKING_DIRECTORY ${WORK} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "failed with ${status}: ${command}\n${output}")
  endif()
endfunction()

run(${PYTHON} -m pip wheel --quiet --no-deps --no-build-isolation --config-settings=build-dir=${BUILD} --wheel-dir ${WORK} ${SOURCE})
file(GLOB wheel ${WORK}/lorica_collision-*.whl)
run(${PYTHON} -m venv --system-site-packages ${WORK}/venv)
run(${WORK}/venv/bin/pip install --quiet ${wheel})
run(${WORK}/venv/bin/python use.py)
run(${WORK}/venv/bin/pip uninstall --quiet --yes lorica)
file(REMOVE_RECURSE ${WORK})
