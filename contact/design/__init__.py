"""A scene with bounds of its data comes in; the best design in them goes out."""
