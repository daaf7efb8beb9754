// A library that needs another, which lies elsewhere. LATE makes the other.
#ifdef LATE
int late_needed(void);

int late_needed(void)
{
	return 1;
}
#else
int late_needed(void);
int late(void);

int late(void)
{
	return late_needed();
}
#endif
