"""The peripheral interrupt expansion (SPRUFB0D section 8)."""
