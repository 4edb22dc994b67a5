list(APPEND core_sources src/solids/surface_name.cpp src/solids/lights.cpp)
if(PLENOFLAME_WITH_SURFACES)
  list(APPEND core_sources src/solids/mesh.cpp src/solids/mesh_obj.cpp src/solids/mesh_ply.cpp
    src/solids/mesh_stl.cpp src/solids/polygon.cpp src/solids/shapes.cpp src/solids/surface_mesh.cpp
    src/solids/surface_scene.cpp
    src/solids/texture.cpp src/solids/triangle_mesh.cpp)
else()
  list(APPEND core_sources src/solids/surface_scene_absent.cpp)
endif()
