"""A session in real time: one loop steps it as a clock says; doors hand bytes in and out between its steps."""
