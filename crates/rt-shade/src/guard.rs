//! Shapes and textures of a stranger, kept from doing harm.
