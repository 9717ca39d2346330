"""The three sensor models of the dissertation, written once against an arithmetic: equations and named parameters."""
