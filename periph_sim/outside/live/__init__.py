"""A session in real time: one loop steps it by a clock; doors transfer bytes between its steps."""
