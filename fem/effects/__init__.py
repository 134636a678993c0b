"""The effects a scene can contain, one small class in one file each."""
