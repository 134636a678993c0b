"""What accuracy costs in time: one case, solved by every model with several meshes."""
