"""The chips of the family, one file each: `PART` is its data."""
