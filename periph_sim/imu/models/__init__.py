"""The three sensor models of the dissertation, written once for any arithmetic: equations and named parameters."""
