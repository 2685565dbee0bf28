"""Many solutions of one scene: load paths with their events, and models side by side."""
