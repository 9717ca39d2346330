"""The other parties on SCL and SDA: controllers, targets, monitors."""
