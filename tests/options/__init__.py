"""Short scenes, at least one for each option, whose records depend on the option."""
