"""GPIO: registers, multiplexer, qualification (SPRUFB0D section 6)."""
