"""What a person writes: profile, material, interaction and control in, a checked scene out."""
