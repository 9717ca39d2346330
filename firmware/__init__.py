"""Reference firmware for the F28335, in Python (`python`), C28x assembly (`c28x`) and C (`c`)."""
