"""A scene and bounds for its data come in; the best design within the bounds goes out."""
