"""Why a field, wire, span or interrupt stood as it did: the walk back from a record to its causes."""
