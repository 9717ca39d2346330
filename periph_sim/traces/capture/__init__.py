"""A capture in memory: channels of edges, their gaps, grids and excerpts."""
