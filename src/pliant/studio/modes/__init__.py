"""What the modes do on the server, beyond single commands."""
