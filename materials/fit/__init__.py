"""Laws of rubber fitted to tests of it: moduli, their errors, and how far they hold."""
