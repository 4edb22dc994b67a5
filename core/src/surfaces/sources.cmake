list(APPEND core_sources src/surfaces/surface_name.cpp src/surfaces/lights.cpp)
if(PLENOFLAME_WITH_SURFACES)
  list(APPEND core_sources src/surfaces/mesh.cpp src/surfaces/shapes.cpp src/surfaces/surface_mesh.cpp
    src/surfaces/surface_scene.cpp
    src/surfaces/texture.cpp src/surfaces/triangle_mesh.cpp)
else()
  list(APPEND core_sources src/surfaces/surface_scene_absent.cpp)
endif()
