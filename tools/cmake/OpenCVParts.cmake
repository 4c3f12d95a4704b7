# The parts of OpenCV that Lorica uses, as targets of the names that OpenCV's own package gives them. That package asks
# for all of OpenCV, with what it needs of a desktop; these parts need a tenth of it.
#
# lorica_find_opencv(core imgproc)
function(lorica_find_opencv)
  find_path(LORICA_OPENCV_INCLUDE opencv2/core.hpp PATH_SUFFIXES opencv4 REQUIRED)
  mark_as_advanced(LORICA_OPENCV_INCLUDE)
  foreach(part ${ARGN})
    find_library(LORICA_OPENCV_${part} opencv_${part} REQUIRED)
    mark_as_advanced(LORICA_OPENCV_${part})
    if(NOT TARGET opencv_${part})
      add_library(opencv_${part} UNKNOWN IMPORTED)
      set_target_properties(opencv_${part} PROPERTIES
        IMPORTED_LOCATION ${LORICA_OPENCV_${part}} INTERFACE_INCLUDE_DIRECTORIES ${LORICA_OPENCV_INCLUDE})
    endif()
  endforeach()
endfunction()
