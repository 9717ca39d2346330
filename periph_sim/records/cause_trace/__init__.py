"""Search for the causes of the value of a field, wire, span or interrupt."""
