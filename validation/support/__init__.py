"""What the cases have in common."""
