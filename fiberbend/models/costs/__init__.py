"""What runs of finite elements take."""
