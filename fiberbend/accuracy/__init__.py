"""What an accuracy asks of a case: what is known of errors, their sum, and the cheapest choice."""
