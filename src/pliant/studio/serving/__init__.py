"""The studio as a server: who may talk to it, and what travels."""
